"""Pictures of rows and poses."""
