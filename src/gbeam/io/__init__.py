"""Files of results: netCDF for studies, CSV and MAT for commands."""
