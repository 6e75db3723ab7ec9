/** Something made of a file of the server, which is asked for once. One that could not be had is null, and asked for again. */
export function fetchedOnce<T>(path: string, make: (content: unknown) => T): () => Promise<T | null> {
  let asked: Promise<T | null> | null = null;
  const ask = async (): Promise<T | null> => {
    const answer = await fetch(path);
    return answer.ok ? make(await answer.json()) : null;
  };
  return () => {
    asked ??= ask()
      .catch(() => null)
      .then((made) => {
        if (made === null) asked = null;
        return made;
      });
    return asked;
  };
}
