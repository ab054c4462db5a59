"""How distributions of bodycheck are built, checked and tried; no package contains this folder."""
