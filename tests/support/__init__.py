"""What several tests share: configurations, designs, oracles."""
