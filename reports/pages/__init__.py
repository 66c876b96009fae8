"""The pages: one package a mechanism (page, experiments, template), and what they share."""
