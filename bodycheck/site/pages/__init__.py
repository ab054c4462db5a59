"""The pages of the site. Each module has the function `pages`, which makes the files of one kind of page from a catalogue."""
