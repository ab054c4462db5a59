"""The audit: what an engine does by itself, found by physics alone from flights with one obvious answer each."""
