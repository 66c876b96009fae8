"""Pictures of rows and poses; these modules do not depend on pages."""
