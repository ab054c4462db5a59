"""The commands of the command line that are not studies.

`command_line` registers all commands, turns errors into messages and exit codes, and is the entry point. Every other module
contains a few related commands: `run` and `export`, `report` and `diff`, and `authoring` has `cases`, `validate`, `new`,
`schema` and `expect`. `ensembles` has `gather` and `query` for the results of ensembles. `saved` reads folders of saved results
for `bodycheck report`, and `cite` has citations. The commands of studies are the modules `command` in the folders of
`bodycheck.studies`.
"""
