"""The public site of results: static pages made from submissions, which are packed results folders from anyone.

`submissions` makes a `Submission` from a results folder, and the zip file of it that `bodycheck submit` writes. It also reads
submissions again, and leaves out invalid ones with the reason. `catalogue` orders the rows of submissions by engine, release,
scene and robot. `cells` makes the cell of an engine and a scene for the front page, `changes` finds changes between dates,
`releases` finds changes between releases, and `known` lists known issues, which are threads upstream. Each module in `pages`
makes one kind of page from a catalogue; other modules here gather the content of larger pages. `build` writes all pages.

Rules: the same submissions give the same files to the last byte, so pages show no time except the times in their data. Only
errors.html shows what is left out.
"""
