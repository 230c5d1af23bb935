"""Model, measure and diagnose tendon-driven robots through their motor currents."""

__version__ = "0.1.0"
