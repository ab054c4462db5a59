"""Case files that come with bodycheck; see `bodycheck cases`."""
