"""The stages of `dvc repro`: read, call the library, write."""
