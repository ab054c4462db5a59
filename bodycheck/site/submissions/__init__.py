"""Submissions: results folders of anyone, packed as files that can be read without trust.

A `submission` has rows of known `tables`, the texts of `cases`, a header (`headers`) and motions (`tracks`, made by `tracing`
of each engine's own method, see `own_methods`). `packing` makes its contents of a results folder, without what is `personal`,
and is the work of the command `bodycheck submit`. `contents` checks them, where `texts` and `plausible` say what cannot be.
`cases` keeps apart cases of several people that have one name. `archive` writes and reads the zip file, and `gathering` finds
all submissions at paths.
"""
