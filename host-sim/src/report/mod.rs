//! What a person or a script reads afterwards: HTML, JSON, CSV, Parquet, terminal table.
