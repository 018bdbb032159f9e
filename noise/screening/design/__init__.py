"""Bushing designs: their use, environments and tolerances."""
