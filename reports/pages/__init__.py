"""The report's pages: a package for each subject, and modules that the pages share."""
