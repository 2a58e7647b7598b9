// The licences of what is bundled, at the head of each script, and so in every report, and in a file that goes with them.

import { writeFileSync } from "node:fs";
import type { Plugin } from "vite";

interface Package {
  name: string;
  version: string;
  text?: string;
}

/** Where Vite leaves the licences of the packages whose modules it bundled (`build.license`). */
export const COLLECTED = "licences.json";
const HEADING = "gbeam itself is under the MIT licence. Its viewer and its pages hold these packages, under theirs:";

/** Put what is collected before the code, and into `file`; a package without a licence ends the build. */
export function notices(file?: string): Plugin {
  return {
    name: "notices",
    generateBundle: {
      order: "post",
      handler(_, bundle) {
        const collected = bundle[COLLECTED];
        if (collected?.type !== "asset") throw new Error(`there is no ${COLLECTED}`);
        const texts = (JSON.parse(String(collected.source)) as Package[]).map(({ name, version, text }) => {
          if (!text) throw new Error(`${name} ${version} is bundled and has no file of its licence`);
          return `${name} ${version}\n\n${text}`;
        });
        const notice = [HEADING, ...texts].join("\n\n");
        delete bundle[COLLECTED];
        for (const part of Object.values(bundle)) if (part.type === "chunk") part.code = `/*!\n${notice}\n*/\n${part.code}`;
        if (file) writeFileSync(file, `${notice}\n`);
      },
    },
  };
}
