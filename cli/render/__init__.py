"""Scenes and their motion as pictures: camera, style, canvas, figure; video and stills made of them."""
