"""Tools that the commands share.

- `options` declares the arguments and options that several commands have, with their help texts.
- `arguments` loads the named cases and engines, and checks paths and numbers before a long run.
- `ran` runs cases in engines for commands.
- `terminal` prints tables and other results to stdout, and progress to stderr. `figures` formats numbers.
"""
