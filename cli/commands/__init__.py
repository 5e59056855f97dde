"""One file a command: ``add_to(commands)`` declares its options, ``run(options)`` does it."""
