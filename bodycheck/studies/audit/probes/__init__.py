"""The probes of the audit: each asks one question of a method by flights with one obvious answer."""
