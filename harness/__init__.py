"""bodycheck."""
