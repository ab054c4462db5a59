"""An independent judge of truths."""
