/** The entries of the form and their query. */
export interface GeneratorForm {
  dialect: string;
  languages: readonly string[];
  only: string;
  exclude: string;
  package: string;
}

export interface Choices {
  readonly languages: readonly { readonly name: string; readonly title: string }[];
  readonly dialects: readonly string[];
}

export interface Check {
  readonly problems: Readonly<Record<string, string>>;
  readonly commands: readonly string[];
}

/** Nothing is checked yet, or nothing can be. */
export const UNCHECKED: Check = { problems: {}, commands: [] };

/** The names that the station takes for a file. */
const FILE_NAME = /^\w[\w .-]{0,99}\.xml$/;

/** Returns the query of a form; a definition file is the body of the request, and the query holds its name. */
export function queryOf(
  form: GeneratorForm,
  file: { readonly name: string } | null,
): Record<string, string | undefined> {
  return {
    dialect: file === null ? form.dialect : undefined,
    file: file !== null && FILE_NAME.test(file.name) ? file.name : undefined,
    languages: form.languages.join(','),
    only: form.only.trim() || undefined,
    exclude: form.exclude.trim() || undefined,
    package: form.package.trim() || undefined,
  };
}

/** Returns the languages with one added or removed, in the order of the list. */
export function toggled(languages: readonly string[], name: string, all: readonly string[]): string[] {
  const chosen = new Set(languages);
  if (!chosen.delete(name)) chosen.add(name);
  return all.filter((each) => chosen.has(each));
}
