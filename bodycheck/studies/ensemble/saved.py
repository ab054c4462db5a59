"""Reading of a saved ensemble."""

from bodycheck.studies.ensemble.report.reporting import again as read

__all__ = ["read"]
