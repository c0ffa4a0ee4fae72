"""Pictures of mechanisms: one drawing for all, from what each declares; it knows no mechanism and no formula."""
