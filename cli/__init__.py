"""The `sketchsim` command: inputs and outputs, drawing, video.  No physics and no recognition."""
