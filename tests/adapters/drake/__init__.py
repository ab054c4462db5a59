"""Tests of the adapter of Drake."""
