"""The test of the diagnosis of rigs: simulated axes that nothing here was tuned for."""
