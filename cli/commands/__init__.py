"""One file a command: ``configure(parser)`` declares its options, ``run(options)`` does it."""
