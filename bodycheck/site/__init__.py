"""The public site of results: static pages made from submissions, which are packed results folders of anyone.

`submissions` makes a `Submission` of a results folder and a zip file of it, which is what `bodycheck submit` writes; it reads
them again, and leaves out what is not as it should be, with the reason. `catalogue` orders their rows by engine, release, scene
and robot; `cells` says what the front page shows of an engine and a scene, `changes` what differs from date to date, `releases`
what a release changed, and `known` which threads upstream are about it. Each module in `pages` makes one kind of page of a
catalogue; modules beside it gather what larger pages show. `build` writes them all.

Rules: the same submissions give the same files to the last byte, so that pages have no time but that of their data. What is
left out appears in errors.html alone.
"""
