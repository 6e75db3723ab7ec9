# `reference`: writes the schema of the configuration from the tables that the loader uses, and the tables of
# keys in docs/ from the schema. Tests compare both with what they would become.
add_custom_target(reference
  COMMAND rc10d --schema > "${PROJECT_SOURCE_DIR}/config/rc10d.schema.json"
  COMMAND "${PROJECT_SOURCE_DIR}/scripts/lib/key_tables.py"
  VERBATIM)
