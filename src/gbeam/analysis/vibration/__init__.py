"""Small vibrations about an equilibrium: modes, Campbell diagrams, loss of stability."""
