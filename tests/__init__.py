"""Tests; a package, so that tests/pipeline is not mistaken for the pipeline itself."""
