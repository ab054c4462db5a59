"""Extensions of Sphinx with which the documentation is built: mathematics, generated reference pages, versions."""
