"""From a picture to ink: the sheet, the light on it, and which pixels were drawn."""
