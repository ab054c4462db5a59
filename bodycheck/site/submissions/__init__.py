"""Submissions: results folders from anyone, packed as files that can be read without trust in their authors.

A `submission` has rows of known `tables`, the texts of `cases`, a header (`headers`) and motions (`tracks`); `tracing` makes
motions for the method that each engine itself chooses (`own_methods`). `packing` implements the command `bodycheck submit`: it
makes the contents of a submission from a results folder, without `personal` data. `contents` checks them; `texts` and
`plausible` have the rules for texts and for rows. `cases` distinguishes cases of the same name from several people. `archive`
writes and reads the zip file, and `gathering` finds all submissions at paths.
"""
