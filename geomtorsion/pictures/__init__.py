"""pictures: what a person looks at: pages, formulas, labels."""
