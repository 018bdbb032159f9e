"""Screening of bushing designs before tooling: maps of noise, critical speeds, margins, ranking."""
