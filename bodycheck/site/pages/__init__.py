"""The pages of the site: each module has `pages`, a function from the catalogue to the files of one kind of page."""
