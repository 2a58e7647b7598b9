"""Responses over time: the study of all environments, their comparisons, and the study of models."""
