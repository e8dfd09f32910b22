"""What a world is made of: layout, obstacles, placement checks; `editing` changes it while a run goes on."""
