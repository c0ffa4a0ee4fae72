"""Pictures of maps, drawn by matplotlib, which is imported when it is needed."""
