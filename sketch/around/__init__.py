"""What is around a reading says what it may mean: marks on bodies, letters in rows, arrows at things."""
