"""The pages: one package a mechanism (page, experiments, expectations, template), and what they share."""
