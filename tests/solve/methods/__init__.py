"""Tests of the methods that keep the structure of a motion."""
