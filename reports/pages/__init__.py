"""The pages: a package for each subject (page, texts, experiments), and the modules that they share."""
