"""Being here, it lets tests of the folders below import the modules beside it."""
