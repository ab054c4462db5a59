// Search from disk, and the choice of a version.
